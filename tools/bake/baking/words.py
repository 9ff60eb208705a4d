"""Formats numbers for display."""


def duration(seconds: float) -> str:
    """Formats a duration, such as 42 s, 3 min 20 s or 2 h 5 min."""
    rounded = round(seconds)
    if rounded < 60:
        return f"{seconds:.1f} s" if seconds < 10 else f"{rounded} s"
    return f"{rounded // 60} min {rounded % 60} s" if rounded < 3600 else f"{rounded // 3600} h {rounded % 3600 // 60} min"


def amount(number: float) -> str:
    """Formats a count, such as 950, 12.3 k, 4.56 M, 1.2 G or 3 T."""
    for factor, unit in ((1e12, " T"), (1e9, " G"), (1e6, " M"), (1e3, " k")):
        if number >= factor:
            return f"{number / factor:.3g}{unit}"
    return f"{number:.0f}"
