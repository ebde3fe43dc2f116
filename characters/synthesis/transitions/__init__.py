"""Motion along the edges of graphs: how frames join, and what answers a request."""
