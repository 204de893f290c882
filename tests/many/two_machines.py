"""Two machines of a Ray cluster, each of one core, on this one: says where they are, until its input ends."""

import json
import sys

from ray.cluster_utils import Cluster

cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
nodes = [cluster.add_node(num_cpus=1, wait=True) for _ in range(2)]
raylets = [node.all_processes["raylet"][0].process.pid for node in nodes]
sys.stdout.write(json.dumps({"address": cluster.address, "raylets": raylets}) + "\n")
sys.stdout.flush()
sys.stdin.read()
cluster.shutdown()
