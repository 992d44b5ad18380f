"""Words of robots that argue and of people who answer them: phrases, moves and other lines, in several languages."""
