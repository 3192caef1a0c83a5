"""The command `mgs` as a module: `python -m mgs`."""

from mgs.cli import main

if __name__ == "__main__":
    main(prog_name="mgs")
