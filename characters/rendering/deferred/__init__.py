"""What deferred passes share: buffers, ambient occlusion, and what blocks the lamp."""
