"""`python -m greywhale`: the same command line as the console script."""

from greywhale.cli import main

if __name__ == "__main__":
    main()
