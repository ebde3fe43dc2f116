"""Studies with people: protocols, who takes part, and what is found."""
