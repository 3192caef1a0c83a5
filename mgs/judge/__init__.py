"""The verdict on a motion: static checks, replays in physics, Monte Carlo draws."""
