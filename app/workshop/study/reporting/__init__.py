"""What a study found: tidy tables, statistics, and a report."""
