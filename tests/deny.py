#!/usr/bin/env python3
"""What `cargo deny check licenses bans sources` asks of the dependencies of the program and of its package for
Python, without installation.

Reads tests/deny.toml; needs Python 3.11 and cargo, and a network for crates that are not there yet. Prints what
breaks a rule (exit code 1), and crates that are there in several versions. A Cargo.lock that is not in step with
the manifests is an error.

    python3 tests/deny.py
"""
import collections, json, pathlib, re, subprocess, sys, tomllib

folder = pathlib.Path(__file__).parent
rules = tomllib.loads((folder / "deny.toml").read_text())
allowed = set(rules["licenses"]["allow"])
metadata = json.loads(subprocess.run(
    ["cargo", "metadata", "--format-version", "1", "--locked"],
    cwd=folder.parent, check=True, stdout=subprocess.PIPE).stdout)


def is_allowed(expression):
    """Whether an SPDX expression can be met with allowed licences. The old "/" means "OR"."""
    terms = re.findall(r"\(|\)|AND|OR|[^\s()/]+(?: WITH [^\s()]+)?|/", expression)
    words = {"AND": "and", "OR": "or", "/": "or", "(": "(", ")": ")"}
    return eval(" ".join(words.get(t) or str(t in allowed) for t in terms))  # only these words and booleans


broken, versions = [], collections.defaultdict(set)
for package in metadata["packages"]:
    name = f"{package['name']} {package['version']}"
    versions[package["name"]].add(package["version"])
    if not is_allowed(package["license"] or "none"):
        broken.append(f"{name}: licence {package['license']}")
    if package["source"] and not package["source"].startswith("registry+"):
        broken.append(f"{name}: comes from {package['source']}")
    if package["source"] is None:
        # A folder has one version.
        broken += [f"{name}: any version of {d['name']}" for d in package["dependencies"]
                   if d["req"] == "*" and not d.get("path")]
for name, found in sorted(versions.items()):
    if len(found) > 1:
        print(f"several versions: {name} {', '.join(sorted(found))}")
print(f"{len(metadata['packages'])} packages, {len(broken)} break a rule")
print("\n".join(broken))
sys.exit(bool(broken))
