"""What kind of motion a recording holds, told before anything is fitted."""
