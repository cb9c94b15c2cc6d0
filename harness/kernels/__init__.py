"""The event-driven integrator with sensitivities, for any model of the five slots."""
