"""Whether a log and a model belong together, before anything is fitted: signs, units, zeros and names of joints."""
