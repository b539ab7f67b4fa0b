"""What scripts have in common that read files of a run and say what differs."""
import sys

faults = []


def expect(what, holds):
    if not holds and what not in faults:
        faults.append(what)


def finish(*summary):
    """Prints the summary; says what differs, and ends with status 1 then."""
    print(*summary)
    if faults:
        sys.exit("differ: " + ", ".join(faults))
