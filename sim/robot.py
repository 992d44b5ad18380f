"""One robot's own software: sense -> estimate -> plan -> drive."""
