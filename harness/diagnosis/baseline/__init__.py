"""The base fit: viscous and Coulomb friction on the restoring force."""
