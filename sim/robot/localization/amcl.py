"""Adaptive Monte Carlo localization: ROS's amcl as a pure function of its inputs.

A cloud of particles represents the pose. At the first scan after enough motion, the cloud is moved, weighed and
resampled (`hypothesis`). If the scans fit the map badly from this pose, a second cloud, the rival, searches for the
robot on the whole map. The tracked pose is reported until the rival has explained scans better for some time. So a
single bad scan, a person near the robot or a closed door does not make the pose jump. The robot is lost if several
scans fit the pose so badly that it cannot be right, or if the rival is better. It is found if some
successive scans agree with the map, and if scans have disproved the best other pose on the map.

Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), table 8.3, sized by KLD sampling (Fox 2003); amcl_node.cpp
and pf.c of ros-planning/navigation for the times and the order of the steps. Docstrings name the differences from amcl.
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
"""A robot is found after this number of scans with a narrow cloud. Scans count while nearly all particles agree on one
pose that fits the map."""

SEARCH_SHARE = 0.2
"""Share of the particles that are drawn from the whole map at each resampling during a search."""

RETRY_TICKS = 25
"""After this number of ticks, the next scan is weighed even if the robot stands still.

This applies to a lost robot, and to a robot with scans that fit badly.
"""

MARGINS = (0.03, 0.1)
"""Additional share of a scan that a rival must explain to be better than the pose. The first value is for a pose that
was found by a recent search, the second for a pose that was set or has been tracked for a long time."""
MOST_OF_ONE_SCAN = 0.25
"""Maximum effect of one scan for or against a rival, so that no single scan decides."""
CHALLENGED = 0.15
"""The tracked pose is not reliable if a rival's lead is above this."""
WON = 1.0
"""Lead at which a rival replaces the tracked pose. A rival needs at least four scans to reach it."""
DOUBT = 0.5
"""Lead that the best other pose gets at the end of a search, or when a rival replaces the pose. The robot is lost until
scans have reduced this lead to 0. This takes two scans that fit the other pose much worse, or seventeen scans that fit
both poses equally, because the two places look alike."""
PROVEN_SCANS = 100
"""Number of scans for which a pose found by a search must be tracked to be as reliable as a set pose. Before that, the
robot may be at another place that looks the same. So it is lost as soon as scans fit worse than usual."""


@frozen(eq=False)
class ParticleBelief:
    """State of the filter between two ticks.

    Attributes:
        tick: tick of the last update.
        base_in_odom: odometry pose at that time.
        place: hypothesis with the tracked pose.
        rival: second hypothesis, or None if there is no reason to search.
        lead: share of a scan that the rival explained, minus the share that the pose explained, summed over recent
            scans; see `WON`.
        anywhere: True while the pose itself is searched on the whole map.
        proven: True if the pose was set, or has been tracked for a long time.
        lost: True if the robot is lost, see `Estimate`.
        requested: True if the next scan is weighed even if the robot has not moved.
        p_wrong: probability that the pose is wrong, see `Estimate`. None before the first scan.
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
        """True if scans are also needed while the robot does not move."""
        return self.lost or self.rival is not None or self.place.agreement.doubtful

    @property
    def odom_in_map(self) -> Pose2:
        """The correction of the last update."""
        return self.place.mean.compose(self.base_in_odom.inverse())


@dataclass(frozen=True, slots=True)
class UniformPrior:
    """State of a filter after global localization, before its next tick."""


AmclState = PosePrior | UniformPrior | ParticleBelief


def saved(parameters: AmclParameters, estimate: Estimate) -> AmclParameters:
    """Return parameters with which a new filter starts at this estimate. amcl stores them on the parameter server."""
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
    """A particle filter over (x, y, theta) that weighs scans by their agreement with the map. See `Localizer`.

    Before the first `start` it assumes the pose in its parameters, as amcl does: by default the map's origin.

    Attributes:
        state: state of the filter. The next estimate depends only on it and on the arguments of `update`.
    """

    def __init__(
        self, parameters: AmclParameters, grid: OccupancyGrid, mount: LaserMount, seed: int, robot: str
    ) -> None:
        """Create a filter for one robot.

        Args:
            parameters: parameters of amcl.
            grid: the static map.
            mount: the laser that makes the scans for `update`.
            seed: random seed of the session.
            robot: name of the robot, e.g. "robot1", so that each robot has its own noise.
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
        """Make the models for these parameters."""
        self._parameters = parameters
        self._clouds = CloudFilter(parameters, self._grid, self._mount)

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Restart around this pose at the next tick. The first scan after it is weighed immediately."""
        self.state = PosePrior(base_in_map, read_only(covariance.copy()))

    def globalize(self) -> None:
        """Restart at the next tick, uniformly over the free cells and all headings."""
        self.state = UniformPrior()

    def widen(self, distance: float, turn: float) -> None:
        """Increase the uncertainty: move the particles of pose and rival randomly, with these standard deviations."""
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
        """Weigh the next scan even if the robot has not moved. The first scan after a start is always weighed."""
        if isinstance(self.state, ParticleBelief):
            self.state = replace(self.state, requested=True)

    def configure(self, parameters: RobotParameters) -> None:
        """Continue with these parameters. If they require a smaller cloud, it shrinks at the next resampling.

        Difference from ROS: amcl draws new particles around the pose that it last reported.
        """
        if parameters.amcl != self._parameters:
            self._use(parameters.amcl)

    @property
    def awaits_scan(self) -> bool:
        """True after the filter has started, because then only scans change its state."""
        return isinstance(self.state, ParticleBelief)

    def ignores_scans(self, odometry: Odometry) -> bool:
        """Return True while a robot that stands is sure of its pose."""
        belief = self.state
        return isinstance(belief, ParticleBelief) and not belief.unsure and not self._due(belief, odometry)

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Process one tick. A scan is weighed if the robot has moved enough since the last weighed scan."""
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
        """Return True if the robot moved far enough along an axis of odom, or turned enough (amcl_node.cpp)."""
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
        """Draw the maximum number of particles around a known pose."""
        n = self._parameters.max_particles
        noise = self._start_noise.normals(odometry.tick, 3 * n).reshape(n, 3)
        particles = start.base_in_map.array() + product(noise, np.ascontiguousarray(root(start.covariance).T))
        particles[:, 2] = (particles[:, 2] + math.pi) % (2.0 * math.pi) - math.pi
        weights = read_only(np.full(n, 1.0 / n))
        place = Hypothesis(read_only(particles), weights, start.base_in_map, start.covariance)
        return ParticleBelief(odometry.tick, odometry.base_in_odom, place)

    def _scatter_everywhere(self, odometry: Odometry) -> ParticleBelief:
        """Draw the maximum number of particles over the whole map. Their mean is the pose until a scan arrives."""
        n = self._parameters.max_particles
        particles = self._free_space.draw(n, self._noise.places, odometry.tick)
        mean = Pose2(*particles.mean(axis=0).tolist())
        weights = read_only(np.full(n, 1.0 / n))
        place = Hypothesis(read_only(particles), weights, mean, read_only(covariance_of(particles)))
        return ParticleBelief(odometry.tick, odometry.base_in_odom, place, anywhere=True, proven=False, lost=True)

    def _weigh(self, belief: ParticleBelief, odometry: Odometry, scan: Scan) -> ParticleBelief:
        """Update the filter with a scan: move, weigh, compare with the rival, and resample if due."""
        view = self._clouds.view(scan, odometry.tick)
        # The first scan may arrive some ticks after the start. The motion until then is included.
        left, reached = belief.base_in_odom, odometry.base_in_odom
        if belief.anywhere and not belief.place.updates and len(view.points):
            place = self._clouds.looked_for(view, self._noise)
        else:
            searching = SEARCH_SHARE if belief.anywhere else 0.0
            place = self._clouds.followed(belief.place, left, reached, view, self._noise, searching)
        rival = belief.rival
        # A pose found by a search is compared with the best other pose.
        besides = None if belief.proven else place.mean
        if rival is not None:
            rival = self._clouds.followed(rival, left, reached, view, self._rival_noise, SEARCH_SHARE, besides)
        elif len(view.points) and self._seeks_rival(belief, place):
            rival = self._clouds.looked_for(view, self._rival_noise, besides)
        now = replace(belief, tick=odometry.tick, base_in_odom=reached, place=place, rival=rival, requested=False)
        now = _found(now) if belief.anywhere else _compared(now)
        return replace(now, p_wrong=probability(PARTICLES, evidence_of(now)))

    def _seeks_rival(self, belief: ParticleBelief, place: Hypothesis) -> bool:
        """Return True if a search has a result, or if scans are suspicious.

        A search may have found a place that only looks like the right place.
        """
        if belief.anywhere:
            return place.settled >= SETTLED_SCANS
        return belief.lead > 0.0 or (self._parameters.recovers and place.agreement.suspicious)


def evidence_of(now: ParticleBelief) -> ParticleEvidence:
    """After an update, collect the features that distinguish right poses from wrong poses."""
    return ParticleEvidence.of(
        now.place, now.lead, lost=now.lost, anywhere=now.anywhere, proven=now.proven, rival=now.rival is not None
    )


def _found(now: ParticleBelief) -> ParticleBelief:
    """End a global search once there is a rival. From then on, the pose is compared with the rival."""
    return now if now.rival is None else replace(now, anywhere=False, lead=DOUBT)


def _compared(now: ParticleBelief) -> ParticleBelief:
    """Compare the pose with its rival. Decide whether the robot is lost, and which of the two poses is tracked."""
    place, rival, lead = now.place, now.rival, now.lead
    if rival is not None and rival.updates > 1:
        # A rival's first scan is no evidence for it, because the rival was chosen to fit this scan.
        better = rival.agreement.last - place.agreement.last - MARGINS[now.proven]
        better = max(-MOST_OF_ONE_SCAN, min(better, MOST_OF_ONE_SCAN))
        apart = elsewhere(rival.mean.array()[np.newaxis], place.mean.x, place.mean.y, place.mean.theta)[0]
        lead = max(0.0, lead + (better if apart else -MOST_OF_ONE_SCAN))
    if rival is not None and now.lost and lead >= WON and rival.settled >= SETTLED_SCANS:
        # Stay lost until one more scan confirms the new pose, so that no jump is reported as certain.
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
