"""Pages of HTML that need nothing else: tables and plots of reports."""
