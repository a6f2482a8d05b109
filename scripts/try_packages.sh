#!/usr/bin/env bash
# Installs the packages in a clean Debian 12 and uses them there as a plain user, without the source
# tree: try_packages.sh FOLDER_OF_DEBS. It needs root (or user namespaces) and mmdebstrap.
set -euo pipefail
debs=$(readlink -f "$1")
root=$(mktemp -d)
trap 'umount "$root/root/proc" 2>/dev/null || true; rm -rf "$root"' EXIT

say() { printf '\n== %s\n' "$*"; }

say 'a clean Debian 12'
mmdebstrap --variant=apt --quiet bookworm "$root/root"
cp "$debs"/*.deb "$root/root/tmp/"
mount -t proc proc "$root/root/proc"
inside() { chroot "$root/root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
as_user() { inside su - tester -c "$1"; }

say 'the programs alone'
inside apt-get -qy update >/dev/null
inside sh -c 'apt-get -qy install --no-install-recommends /tmp/breakwater_*.deb' >"$root/log" || { cat "$root/log"; exit 1; }
inside useradd --create-home tester
as_user 'breakwater --version && breakwater list'
as_user 'breakwater run arm_push --case drac-link1 --duration 2 --set push.start_s=0.2 --out run --quiet'
as_user '! breakwater video run --size 320x180 --quiet'
inside apt-get -qy install --no-install-recommends ffmpeg >/dev/null  # recommended
as_user 'breakwater video run --size 320x180 --quiet && breakwater report run --quiet && ls run'
as_user 'breakwater reproduce --only 2.4.3.2 --quick --quiet --out page && ls page | head -4'
inside sh -c 'man -w breakwater >/dev/null 2>&1 || ls /usr/share/man/man1/breakwater.1.gz'

say 'the Python module'
inside sh -c 'apt-get -qy install --no-install-recommends /tmp/breakwater_*.deb /tmp/python3-breakwater_*.deb' >"$root/log" || { cat "$root/log"; exit 1; }
as_user "python3 -c \"
import breakwater as bw
run = bw.run('motor_estimation', case='stf', duration=1, out='from-python')
print(run)
print(bw.Stf(*bw.damped_inertia(1.0), delta=1e-3, period_s=1e-3).filter(run['applied_Nm'], run['position_measured_rad']).d[-1])
run.video('motor.mp4', to_s=0.2, size='320x180')\" && ls from-python motor.mp4"
as_user 'breakwater estimate --csv /usr/share/breakwater/data/estimate/motor.csv --quiet --out est --set plant.inertia=1e-3 encoder.quantum=0.00153398 csv.position_scale=0.00153398 csv.input_scale=0.068 && ls est'

say 'a project of one'"'"'s own'
inside sh -c 'apt-get -qy install --no-install-recommends /tmp/*.deb ninja-build' >"$root/log" || { cat "$root/log"; exit 1; }
as_user 'breakwater new controller admittance && cd admittance && cmake --preset release >/dev/null &&
  cmake --build --preset release >/dev/null && ctest --preset release | tail -3 &&
  build/admittance_lab run arm_push --set controller.name=admittance --duration 1 --quiet && ls runs/arm_push'
say 'the packages work in a clean Debian 12'
