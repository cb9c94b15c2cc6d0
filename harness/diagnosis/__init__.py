"""Where a simulation and a recording part, which physics was left out, and the model that has it."""
