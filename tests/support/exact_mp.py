"""An independent evaluation of the free decay to 50 digits: complex roots, no shared code or formulas."""

from dataclasses import dataclass

import mpmath as mp

DIGITS = 50


@dataclass
class Piece:
    begin: mp.mpf
    end: mp.mpf
    centre: mp.mpf
    weights: tuple[mp.mpc, mp.mpc] | None  # of exp(root tau); None at rest
    roots: tuple[mp.mpc, mp.mpc]


class HighPrecisionDecay:
    """x'' + 2 zeta omega x' + omega^2 (x + x_k sgn x') = 0 by its characteristic roots, piece after piece."""

    def __init__(
        self, omega_n: mp.mpf, zeta: mp.mpf, x_k: mp.mpf, x_s: mp.mpf, x0: mp.mpf, v0: mp.mpf, pieces: int = 4000
    ) -> None:
        with mp.workdps(DIGITS):
            self.w, self.z = mp.mpf(omega_n), mp.mpf(zeta)
            self.x_k, self.x_s = mp.mpf(x_k), mp.mpf(x_s)
            if self.z == 1:  # a double root: split it far below the precision asked for
                self.z = 1 + mp.mpf(10) ** -44
            split = mp.sqrt(mp.mpc(self.z * self.z - 1))
            self.roots = (self.w * (-self.z + split), self.w * (-self.z - split))
            self.pieces: list[Piece] = []
            self.turning: list[mp.mpf] = []
            self.stick_time: mp.mpf | None = None
            begin, x, v = mp.mpf(0), mp.mpf(x0), mp.mpf(v0)
            while len(self.pieces) < pieces:
                if v == 0:
                    self.turning.append(x)
                    if abs(x) <= self.x_s:
                        self.stick_time = begin
                        self.pieces.append(Piece(begin, mp.inf, x, None, self.roots))
                        return
                direction = mp.sign(v) if v != 0 else -mp.sign(x)
                centre = -direction * self.x_k
                y = x - centre
                r1, r2 = self.roots
                w1 = (v - r2 * y) / (r1 - r2)
                w2 = y - w1
                tau = self._rest(w1, w2, v != 0)
                self.pieces.append(Piece(begin, begin + tau, centre, (w1, w2), self.roots))
                if tau == mp.inf:
                    return
                x = centre + mp.re(w1 * mp.exp(r1 * tau) + w2 * mp.exp(r2 * tau))
                v = mp.mpf(0)
                begin += tau

    def _rest(self, w1: mp.mpc, w2: mp.mpc, moving: bool) -> mp.mpf:
        """First time > 0 at which w1 r1 e^(r1 t) + w2 r2 e^(r2 t) = 0."""
        r1, r2 = self.roots
        ratio = -w2 * r2 / (w1 * r1) if w1 != 0 else mp.inf
        if self.z < 1:
            period = 2 * mp.pi / mp.im(r1 - r2)
            if not moving:
                return period
            # e^((r1-r2) t) = ratio, |ratio| = 1
            return (mp.arg(ratio) / mp.im(r1 - r2)) % period
        if not moving or ratio == mp.inf or mp.re(ratio) <= 1:
            return mp.inf
        return mp.re(mp.log(ratio) / (r1 - r2))

    def __call__(self, t: float) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
        with mp.workdps(DIGITS):
            time = mp.mpf(t)
            piece = next(p for p in self.pieces if p.begin <= time < p.end)
            if piece.weights is None:
                return piece.centre, mp.mpf(0), mp.mpf(0)
            (w1, w2), (r1, r2) = piece.weights, piece.roots
            tau = time - piece.begin
            e1, e2 = w1 * mp.exp(r1 * tau), w2 * mp.exp(r2 * tau)
            return (piece.centre + mp.re(e1 + e2), mp.re(r1 * e1 + r2 * e2), mp.re(r1 * r1 * e1 + r2 * r2 * e2))
