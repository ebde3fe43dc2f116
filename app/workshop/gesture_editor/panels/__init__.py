"""What the window shows, by Dear ImGui: bars, the inspector, the time line and cards."""
