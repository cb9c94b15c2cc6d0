"""Two traces over each other, and two channels of one recording."""
