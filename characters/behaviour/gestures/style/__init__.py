"""How a gesture is done: its easing, its curve, and how far the trunk goes along."""
