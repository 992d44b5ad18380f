"""Adaptive Monte Carlo localization: ROS's amcl as a function of values.

When the robot has moved enough and a scan is there, the cloud of particles that stands for its place is moved, weighed
and drawn anew (`hypothesis`). Where the map explains the scans badly from there, the robot is looked for all over the
map by a second cloud, the rival. What is reported stays the place that was tracked until the rival has explained scans
better for long: one bad scan, a person in the way or a door that was closed move nothing. The robot is lost when the
place has explained several scans so badly that it cannot be right, or when the rival is better; it is found when
particles and map agree for some scans in a row, and scans have spoken against the best other place of the map.

Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), table 8.3, sized by KLD sampling (Fox 2003); amcl_node.cpp
and pf.c of ros-planning/navigation for when and in which order. Where this differs from amcl the docstrings say so.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from sim.common.frozen import frozen
from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import Imu, LaserMount, Odometry, Scan
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.matrices import covariance_of, product, root
from sim.numerics.noise_arrays import NoiseStream
from sim.parameters import AmclParameters, RobotParameters
from sim.robot.localization.estimate import Estimate, PosePrior, read_only
from sim.robot.localization.free_space import FreeSpace, elsewhere
from sim.robot.localization.hypothesis import CloudFilter, CloudNoise, Hypothesis, widened
from sim.robot.localization.wrong_pose import ParticleEvidence, probability
from sim.robot.localization.wrong_pose_coefficients import PARTICLES

SETTLED_SCANS = 5
"""Scans after which the cloud must be narrow for the robot to be found, while nearly all particles agree on one place
that the map explains."""

SEARCH_SHARE = 0.2
"""Share of the particles that are looked for all over the map every time that they are drawn, in a search."""

RETRY_TICKS = 25
"""Ticks until a robot that is lost, or whose scans are badly explained, weighs the next one even if it stands."""

MARGINS = (0.03, 0.1)
"""Share of a scan that a rival must explain more to be any better than a place that was found by searching not long
ago, and than one that was told or has been tracked for long."""
MOST_OF_ONE_SCAN = 0.25
"""A scan counts no more than this for or against a rival: no single one decides."""
CHALLENGED = 0.15
"""Lead of a rival from which on the place can no longer be relied on."""
WON = 1.0
"""Lead with which a rival takes the place: four scans at least."""
DOUBT = 0.5
"""Lead of the best other place when a search ends, or when a rival has taken the place. The robot is lost until scans
have used it up: two scans that explain the other place much worse, or seventeen that explain it as well because it is a
twin."""
PROVEN_SCANS = 100
"""Scans for which a place that was found by searching must be tracked to be as sure as one that was told. Until then it
may be a twin of the right one, and the robot is lost as soon as the place explains less than usual."""


@frozen(eq=False)
class ParticleBelief:
    """All that the filter remembers between two ticks.

    Attributes:
        tick: that of the last update.
        base_in_odom: the odometry then.
        place: where the robot is held to be.
        rival: where else it may be, as long as there is reason to look.
        lead: by how much the rival has explained scans better of late, see `WON`.
        anywhere: True while the place itself is looked for all over the map.
        proven: True if the place was told, or has been tracked for long.
        lost: the verdict, see `Estimate`.
        requested: True if the next scan is weighed in any case.
        p_wrong: probability that the place is wrong, see `Estimate`; None before the first scan.
    """

    tick: int
    base_in_odom: Pose2
    place: Hypothesis
    rival: Hypothesis | None = None
    lead: float = 0.0
    anywhere: bool = False
    proven: bool = True
    lost: bool = False
    requested: bool = False
    p_wrong: float | None = None

    @property
    def unsure(self) -> bool:
        """True when more scans are wanted than the robot's movement brings."""
        return self.lost or self.rival is not None or self.place.agreement.doubtful

    @property
    def odom_in_map(self) -> Pose2:
        """The correction found at the last update."""
        return self.place.mean.compose(self.base_in_odom.inverse())


@dataclass(frozen=True, slots=True)
class UniformPrior:
    """State of a filter that was told to forget where it was, and has seen no tick since."""


AmclState = PosePrior | UniformPrior | ParticleBelief


def saved(parameters: AmclParameters, estimate: Estimate) -> AmclParameters:
    """Return the parameters with which a new filter begins where this estimate ends, as amcl writes to the parameter server."""
    pose, variances = estimate.base_in_map, np.diag(estimate.covariance)
    return replace(
        parameters,
        initial_pose_x=pose.x,
        initial_pose_y=pose.y,
        initial_pose_a=pose.theta,
        initial_cov_xx=float(variances[0]),
        initial_cov_yy=float(variances[1]),
        initial_cov_aa=float(variances[2]),
    )


class Amcl:
    """A particle filter over (x, y, theta) that weighs scans against the map; see `Localizer`.

    Before the first `start` it believes to be where its parameters say, as amcl does: at the map's origin by default.

    Attributes:
        state: everything the next estimate depends on, besides the arguments of `update`.
    """

    def __init__(
        self, parameters: AmclParameters, grid: OccupancyGrid, mount: LaserMount, seed: int, robot: str
    ) -> None:
        """Return a filter for one robot.

        Args:
            parameters: amcl's.
            grid: the static map.
            mount: the laser whose scans `update` will bring.
            seed: the session's.
            robot: its name, e.g. "robot1": no two robots draw the same noise.
        """
        self._grid = grid
        self._mount = mount
        self._free_space = FreeSpace(grid)
        self._use(parameters)
        self._start_noise = NoiseStream.named(seed, robot, "amcl", "start")
        self._widening_noise = NoiseStream.named(seed, robot, "amcl", "widening")
        self._noise = CloudNoise.named(seed, robot, "amcl")
        self._rival_noise = CloudNoise.named(seed, robot, "amcl", "rival")
        pose = Pose2(parameters.initial_pose_x, parameters.initial_pose_y, wrap_angle(parameters.initial_pose_a))
        variances = (parameters.initial_cov_xx, parameters.initial_cov_yy, parameters.initial_cov_aa)
        self.state: AmclState = PosePrior(pose, read_only(np.diag(variances)))

    def _use(self, parameters: AmclParameters) -> None:
        """Make the models that these parameters ask for."""
        self._parameters = parameters
        self._clouds = CloudFilter(parameters, self._grid, self._mount)

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Begin anew around this pose, at the next tick; the first scan from then on is weighed at once."""
        self.state = PosePrior(base_in_map, read_only(covariance.copy()))

    def globalize(self) -> None:
        """Begin anew at the next tick, uniformly over the free cells and all headings."""
        self.state = UniformPrior()

    def widen(self, distance: float, turn: float) -> None:
        """Doubt the pose more: the particles of the place and of its rival are moved by as much at random."""
        spread = (distance, distance, turn)
        variances = np.diag([each * each for each in spread])
        match self.state:
            case PosePrior(base_in_map=base_in_map, covariance=covariance):
                self.state = PosePrior(base_in_map, read_only(covariance + variances))
            case ParticleBelief(tick=tick, place=place, rival=rival):
                draws = self._widening_noise
                place = widened(place, spread, draws.normals(tick, 3 * len(place.particles)))
                rival = rival and widened(rival, spread, draws.normals(tick, 3 * len(rival.particles)))
                self.state = replace(self.state, place=place, rival=rival)

    def request_update(self) -> None:
        """Weigh the next scan even if the robot has not moved; the first scan after a start is weighed anyway."""
        if isinstance(self.state, ParticleBelief):
            self.state = replace(self.state, requested=True)

    def configure(self, parameters: RobotParameters) -> None:
        """Go on with these parameters; a smaller cloud is drawn with the next generation.

        Differs: amcl draws its particles anew, around the pose that it last reported.
        """
        if parameters.amcl != self._parameters:
            self._use(parameters.amcl)

    @property
    def awaits_scan(self) -> bool:
        """True once it has begun: only scans are weighed."""
        return isinstance(self.state, ParticleBelief)

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Take in one tick; a scan is weighed when the robot has moved enough since the last one that was."""
        belief = self.state
        if isinstance(belief, PosePrior):
            belief = self.state = self._scatter(belief, odometry)
        elif isinstance(belief, UniformPrior):
            belief = self.state = self._scatter_everywhere(odometry)
        updated = scan is not None and self._due(belief, odometry)
        if scan is not None and updated:
            belief = self.state = self._weigh(belief, odometry, scan)
        return Estimate(
            tick=odometry.tick,
            base_in_map=belief.odom_in_map.compose(odometry.base_in_odom),
            odom_in_map=belief.odom_in_map,
            covariance=belief.place.covariance,
            particles=belief.place.particles,
            updated=updated,
            lost=belief.lost,
            agreement=belief.place.agreement.last if belief.place.updates else None,
            p_wrong=belief.p_wrong,
        )

    def _due(self, belief: ParticleBelief, odometry: Odometry) -> bool:
        """Return True if the robot moved enough along an axis of the odom frame, or turned enough (amcl_node.cpp)."""
        before, now, limit = belief.base_in_odom, odometry.base_in_odom, self._parameters.update_min_d
        return (
            belief.place.updates == 0
            or belief.requested
            or abs(now.x - before.x) > limit
            or abs(now.y - before.y) > limit
            or abs(wrap_angle(now.theta - before.theta)) > self._parameters.update_min_a
            or (belief.unsure and odometry.tick - belief.tick >= RETRY_TICKS)
        )

    def _scatter(self, start: PosePrior, odometry: Odometry) -> ParticleBelief:
        """Draw as many particles as allowed around a pose that is known."""
        n = self._parameters.max_particles
        noise = self._start_noise.normals(odometry.tick, 3 * n).reshape(n, 3)
        particles = start.base_in_map.array() + product(noise, np.ascontiguousarray(root(start.covariance).T))
        particles[:, 2] = (particles[:, 2] + math.pi) % (2.0 * math.pi) - math.pi
        weights = read_only(np.full(n, 1.0 / n))
        place = Hypothesis(read_only(particles), weights, start.base_in_map, start.covariance)
        return ParticleBelief(odometry.tick, odometry.base_in_odom, place)

    def _scatter_everywhere(self, odometry: Odometry) -> ParticleBelief:
        """Draw as many particles as allowed over the whole map; their mean stands for a pose until a scan comes."""
        n = self._parameters.max_particles
        particles = self._free_space.draw(n, self._noise.places, odometry.tick)
        mean = Pose2(*particles.mean(axis=0).tolist())
        weights = read_only(np.full(n, 1.0 / n))
        place = Hypothesis(read_only(particles), weights, mean, read_only(covariance_of(particles)))
        return ParticleBelief(odometry.tick, odometry.base_in_odom, place, anywhere=True, proven=False, lost=True)

    def _weigh(self, belief: ParticleBelief, odometry: Odometry, scan: Scan) -> ParticleBelief:
        """Do one round of the filter: move, weigh, compare, and every so often resample."""
        view = self._clouds.view(scan, odometry.tick)
        # The first scan may come ticks after the start; whatever was driven until then counts all the same.
        left, reached = belief.base_in_odom, odometry.base_in_odom
        if belief.anywhere and not belief.place.updates and len(view.points):
            place = self._clouds.looked_for(view, self._noise)
        else:
            searching = SEARCH_SHARE if belief.anywhere else 0.0
            place = self._clouds.followed(belief.place, left, reached, view, self._noise, searching)
        rival = belief.rival
        # A place that a search found is compared with the best other one.
        besides = None if belief.proven else place.mean
        if rival is not None:
            rival = self._clouds.followed(rival, left, reached, view, self._rival_noise, SEARCH_SHARE, besides)
        elif len(view.points) and self._seeks_rival(belief, place):
            rival = self._clouds.looked_for(view, self._rival_noise, besides)
        now = replace(belief, tick=odometry.tick, base_in_odom=reached, place=place, rival=rival, requested=False)
        now = _found(now) if belief.anywhere else _compared(now)
        return replace(now, p_wrong=probability(PARTICLES, evidence_of(now)))

    def _seeks_rival(self, belief: ParticleBelief, place: Hypothesis) -> bool:
        """Return True if a search has a result, which may be a twin of the right place, or scans are suspicious."""
        if belief.anywhere:
            return place.settled >= SETTLED_SCANS
        return belief.lead > 0.0 or (self._parameters.recovers and place.agreement.suspicious)


def evidence_of(now: ParticleBelief) -> ParticleEvidence:
    """Collect the features after an update that distinguish right places from wrong ones."""
    return ParticleEvidence.of(
        now.place, now.lead, lost=now.lost, anywhere=now.anywhere, proven=now.proven, rival=now.rival is not None
    )


def _found(now: ParticleBelief) -> ParticleBelief:
    """End the search for a robot that might be anywhere when it has a result; that is compared from then on."""
    return now if now.rival is None else replace(now, anywhere=False, lead=DOUBT)


def _compared(now: ParticleBelief) -> ParticleBelief:
    """Compare the place with its rival: is the robot lost, and which of them is believed from now on?"""
    place, rival, lead = now.place, now.rival, now.lead
    if rival is not None and rival.updates > 1:
        # The scan that it was looked for with says nothing for it.
        better = rival.agreement.last - place.agreement.last - MARGINS[now.proven]
        better = max(-MOST_OF_ONE_SCAN, min(better, MOST_OF_ONE_SCAN))
        apart = elsewhere(rival.mean.array()[np.newaxis], place.mean.x, place.mean.y, place.mean.theta)[0]
        lead = max(0.0, lead + (better if apart else -MOST_OF_ONE_SCAN))
    if rival is not None and now.lost and lead >= WON and rival.settled >= SETTLED_SCANS:
        # The robot stays lost while the new place is compared with the best other one: no jump is told as certain.
        place = replace(rival, settled=SETTLED_SCANS - 1)
        return replace(now, place=place, rival=None, lead=DOUBT, proven=False)
    if now.lost:
        lost = place.settled < SETTLED_SCANS or lead > 0.0
    else:
        suspicious = not now.proven and place.agreement.suspicious
        lost = place.agreement.lost or lead >= CHALLENGED or suspicious
    proven = now.proven or (not lost and place.updates >= PROVEN_SCANS)
    if lost or lead > 0.0 or place.agreement.suspicious:
        return replace(now, lead=lead, proven=proven, lost=lost)
    return replace(now, rival=None, lead=0.0, proven=proven, lost=False)
