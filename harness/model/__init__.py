"""What a model of a slider is made of: five slots, a registry of terms, model.json. Imports core only."""
