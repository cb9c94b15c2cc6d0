"""The sensor model, and motions read at the times of a recording."""
