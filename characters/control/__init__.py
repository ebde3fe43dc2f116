"""From commands to a posed character."""
