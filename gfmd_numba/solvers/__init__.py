"""Methods that find static equilibrium, and the certificate of what they found."""
