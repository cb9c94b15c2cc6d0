"""Whether several recordings are of one machine as it was, and what differs between them where they are not."""
