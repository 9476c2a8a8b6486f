"""What the walls of the paper's slot do to its part: strategies measured in the event-driven engine."""
