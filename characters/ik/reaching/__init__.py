"""Upper bodies that reach: torso, arms, hands and the shapes of hands."""
