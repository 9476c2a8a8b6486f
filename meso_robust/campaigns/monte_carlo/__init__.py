"""How often a plan ends in its goal, with an exact interval."""
