"""What joints of a real robot did, compared with the motion that it was told to execute."""
