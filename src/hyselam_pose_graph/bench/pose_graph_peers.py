#!/usr/bin/env python3
"""Optimises a pose graph of the plane with GTSAM and g2o, as far as this Python has them.

usage: pose_graph_peers.py GRAPH.g2o[.gz] [--best COST]

Prints one JSON object: {"peer": [{"setting", "seconds", "cost", "iterations"} | {"setting", "failed"}]
or a sentence why the peer is not there}. Seconds are CPU time of the optimisation alone, ordering and
analysis included, reading and building the graph excluded; the median of five, on one core. g2o has no
test of convergence: it gets as many iterations as bring it within 0.1 % of COST.
"""
import argparse
import gzip
import json
import math
import os
import statistics
import sys
import time

RUNS = 5


class Graph:
    def __init__(self, path):
        opened = gzip.open(path, "rt") if path.endswith(".gz") else open(path)
        with opened as f:
            lines = f.read().splitlines()
        self.poses, self.edges = {}, []
        for line in lines:
            w = line.split()
            if w and w[0] == "VERTEX_SE2":
                self.poses[int(w[1])] = tuple(map(float, w[2:5]))
            elif w and w[0] == "EDGE_SE2":
                self.edges.append((int(w[1]), int(w[2]), tuple(map(float, w[3:6])), tuple(map(float, w[6:12]))))
        if not self.poses:
            self.compose()
        self.first = min(self.poses)

    def compose(self):
        """Poses along the edges between neighbours, for files without poses."""
        steps = {(a, b): z for a, b, z, _ in self.edges}
        key = min(min(a, b) for a, b, _, _ in self.edges)
        self.poses[key] = (0.0, 0.0, 0.0)
        while (key, key + 1) in steps:
            (x, y, t), (dx, dy, dt) = self.poses[key], steps[key, key + 1]
            c, s = math.cos(t), math.sin(t)
            key += 1
            self.poses[key] = (x + c * dx - s * dy, y + s * dx + c * dy, math.remainder(t + dt, 2 * math.pi))

    def cost(self, poses):
        total = 0.0
        for a, b, (zx, zy, zt), (xx, xy, xt, yy, yt, tt) in self.edges:
            (ax, ay, at), (bx, by, bt) = poses[a], poses[b]
            c, s = math.cos(at), math.sin(at)
            px, py = c * (bx - ax) + s * (by - ay) - zx, -s * (bx - ax) + c * (by - ay) - zy
            c, s = math.cos(zt), math.sin(zt)
            ex, ey, et = c * px + s * py, -s * px + c * py, math.remainder(bt - at - zt, 2 * math.pi)
            total += xx * ex * ex + yy * ey * ey + tt * et * et + 2 * (xy * ex * ey + xt * ex * et + yt * ey * et)
        return total


def matrix(upper):
    import numpy
    xx, xy, xt, yy, yt, tt = upper
    return numpy.array([[xx, xy, xt], [xy, yy, yt], [xt, yt, tt]])


def timed(setting, once):
    """once() -> (seconds, iterations, cost or None): runs it a few times."""
    seconds = []
    for _ in range(RUNS):
        try:
            spent, iterations, cost = once()
        except Exception as error:  # whatever the library throws: it did not solve this graph
            return {"setting": setting, "failed": str(error).strip().splitlines()[0]}
        seconds.append(spent)
        if spent > 2.0:
            break
    return {"setting": setting, "seconds": statistics.median(seconds), "iterations": iterations, "cost": cost}


def run_gtsam(graph):
    try:
        import gtsam
    except ImportError as error:
        return f"not installed ({error})"
    factors, guess = gtsam.NonlinearFactorGraph(), gtsam.Values()
    for key, pose in graph.poses.items():
        guess.insert(key, gtsam.Pose2(*pose))
    for a, b, z, information in graph.edges:
        noise = gtsam.noiseModel.Gaussian.Information(matrix(information), True)
        factors.add(gtsam.BetweenFactorPose2(a, b, gtsam.Pose2(*z), noise))
    hold = gtsam.noiseModel.Isotropic.Sigma(3, 1e-6)
    factors.add(gtsam.PriorFactorPose2(graph.first, guess.atPose2(graph.first), hold))

    def solve(optimizer, params, initialise):
        def once():
            begin = time.process_time()
            start = initialise() if initialise else guess
            solver = optimizer(factors, start, params())
            result = solver.optimize()
            spent = time.process_time() - begin
            poses = {k: (p.x(), p.y(), p.theta()) for k in graph.poses for p in [result.atPose2(k)]}
            return spent, solver.iterations(), graph.cost(poses)
        return once

    return [
        timed("GN", solve(gtsam.GaussNewtonOptimizer, gtsam.GaussNewtonParams, None)),
        timed("LM", solve(gtsam.LevenbergMarquardtOptimizer, gtsam.LevenbergMarquardtParams, None)),
        timed("LAGO, GN", solve(gtsam.GaussNewtonOptimizer, gtsam.GaussNewtonParams,
                                lambda: gtsam.lago.initialize(factors))),
    ]


def run_g2o(graph, best):
    try:
        import g2o
    except ImportError as error:
        return f"not installed ({error})"

    def build(algorithm):
        optimizer = g2o.SparseOptimizer()
        optimizer.set_algorithm(algorithm(g2o.BlockSolverSE2(g2o.LinearSolverEigenSE2())))
        vertices = {}
        for key, pose in graph.poses.items():
            vertex = g2o.VertexSE2()
            vertex.set_id(key)
            vertex.set_estimate(g2o.SE2(*pose))
            vertex.set_fixed(key == graph.first)
            optimizer.add_vertex(vertex)
            vertices[key] = vertex
        for a, b, z, information in graph.edges:
            edge = g2o.EdgeSE2()
            edge.set_vertex(0, vertices[a])
            edge.set_vertex(1, vertices[b])
            edge.set_measurement(g2o.SE2(*z))
            edge.set_information(matrix(information))
            optimizer.add_edge(edge)
        return optimizer, vertices

    def solve(algorithm, iterations):
        def once():
            optimizer, vertices = build(algorithm)
            begin = time.process_time()
            optimizer.initialize_optimization()
            done = optimizer.optimize(iterations)
            spent = time.process_time() - begin
            poses = {k: tuple(v.estimate().to_vector()) for k, v in vertices.items()}
            return spent, done, graph.cost(poses)
        return once

    runs = []
    for name, algorithm in (("GN", g2o.OptimizationAlgorithmGaussNewton),
                            ("LM", g2o.OptimizationAlgorithmLevenberg)):
        needed = 20
        for iterations in range(2, 21):
            if best and solve(algorithm, iterations)()[2] <= 1.001 * best:
                needed = iterations
                break
        runs.append(timed(name, solve(algorithm, needed)))
    return runs


def main():
    title, usage, details = __doc__.split("\n\n", 2)
    parser = argparse.ArgumentParser(usage=usage[len("usage: "):], description=f"{title}\n\n{details}",
                                     formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("graph")
    parser.add_argument("--best", type=float, help="the lowest cost known")
    parser.add_argument("--peer", choices=["gtsam", "g2o"], help="this one alone")
    args = parser.parse_args()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    graph = Graph(args.graph)
    peers = {"gtsam": lambda: run_gtsam(graph), "g2o": lambda: run_g2o(graph, args.best)}
    chosen = [args.peer] if args.peer else peers
    print(json.dumps({peer: peers[peer]() for peer in chosen}))
    sys.stdout.flush()
    os._exit(0)  # the bindings of g2o may crash while they are taken down


if __name__ == "__main__":
    main()
