"""Writes the scripts of a manifest's containers as 0.sh and 1.sh.

usage: k8s_scripts.py MANIFEST.yaml
"""
import sys

import yaml

with open(sys.argv[1], encoding="utf-8") as file:
    jobs = list(yaml.safe_load_all(file))
assert [job["kind"] for job in jobs] == ["Job", "Job"], jobs
for number, job in enumerate(jobs):
    (container,) = job["spec"]["template"]["spec"]["containers"]
    assert container["command"] == ["/bin/sh", "-euc"], container
    with open(f"{number}.sh", "w", encoding="utf-8") as file:
        file.write(container["args"][0])
