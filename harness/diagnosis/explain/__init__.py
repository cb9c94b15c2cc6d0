"""What is said of an outcome: mechanisms, where, held-out prediction, engines, attribution."""
