"""Whether two results files hold the same: every variable, to the bit. Needs h5py."""

import h5py


def variables(path):
    """All datasets of a file, by name: type, shape and bytes."""
    found = {}

    def take(name, one):
        if isinstance(one, h5py.Dataset):
            data = one[...]
            numbers = [str(word) for word in data.ravel()] if data.dtype.kind == "O" else data.tobytes()
            found[name] = (one.dtype.str, one.shape, numbers)

    with h5py.File(path) as file:
        file.visititems(take)
    return found


def differing(one, other):
    """Names of the variables that are not the same in both files."""
    ours, theirs = variables(one), variables(other)
    return sorted(name for name in ours.keys() | theirs.keys() if ours.get(name) != theirs.get(name))
