"""What a practitioner would do without the diagnosis, on the same recordings; each is to be beaten clearly."""
