# SPDX-License-Identifier: MIT
"""A motion of the CNC872 along a path, in whole numbers, from the text of its specification alone (NM1 to NM4)."""


def to_speed(feed):
    """mm/min -> u/T."""
    return feed * 16384 // 15


def to_acceleration(a):
    """mm/s^2 -> u/T^2, the nearest."""
    return (a * 65536 * 2 + 1000) // 2000


def brake(w, a):
    n = w // a
    return n * w - a * n * (n + 1) // 2


class Path:
    """The moving average is a list; the input stage finds its speed by halving."""

    def __init__(self, length, a, n):
        self.length, self.done, self.a, self.n = length, 0, a, n
        self.history, self.carry, self.u, self.v, self.left = [0] * n, 0, 0, 0, length

    def copy(self):
        other = Path(self.length, self.a, self.n)
        other.__dict__.update(self.__dict__)
        other.history = self.history[:]
        return other

    def rest(self):
        return self.length - self.done

    def is_at_rest(self):
        return self.u == 0 and self.v == 0 and (self.n == 1 or not any(self.history))

    def change(self, a, n):
        if (a, n) == (self.a, self.n):
            return True
        left = self.rest() - (self.v * (n - 1) + 1) // 2
        if left < brake(self.v, a):
            return False
        self.a, self.n, self.u, self.history, self.left = a, n, self.v, [self.v] * n, left
        self.carry = n // 2 if self.v * (n - 1) % 2 else 0
        return True

    def halt(self):
        self.u = self.v = self.carry = 0
        self.history, self.left = [0] * self.n, self.rest()

    def pick(self, target, allows):
        low = max(0, self.u - self.a)
        high = max(low, min(self.u + self.a, max(target, self.u - self.a)))
        fits = lambda w: w + brake(w, self.a) <= self.left and allows(w)
        if not fits(low):
            return min(low, self.left)
        while low < high:
            middle = (low + high + 1) // 2
            low, high = (middle, high) if fits(middle) else (low, middle - 1)
        return low

    def step(self, target, hold=None, allows=lambda w: True):
        w = self.pick(target, allows)
        if hold is not None:
            w = min(w, max(0, self.u - hold))
        self.u, self.left = w, self.left - w
        if self.n == 1:
            self.v = w
        else:
            self.history = self.history[1:] + [w]
            total = sum(self.history) + self.carry
            self.v, self.carry = total // self.n, total % self.n
        self.done += self.v
