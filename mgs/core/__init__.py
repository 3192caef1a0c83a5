"""What every room of mgs stands on: errors, geometry, curves, contacts, files, constants."""
