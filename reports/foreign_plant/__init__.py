"""A plan carried out in a plant that shares no physics with the simulator."""
