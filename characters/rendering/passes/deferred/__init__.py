"""The passes of deferred shading, in place of those that shade triangles as they are drawn."""
