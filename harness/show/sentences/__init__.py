"""What results say, in sentences with numbers, for pages and for people."""
