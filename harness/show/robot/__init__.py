"""Pages and traces of a robot and its joints."""
