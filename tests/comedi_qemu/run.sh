#!/bin/sh
# Boots Debian's kernel in QEMU (software emulation) with its comedi_test driver and runs a probe of the Comedi backend
# against /dev/comedi0.   run.sh PROBE FOLDER     exit code 77: skipped, with the reason
# Kernel: the newest of /boot and /lib/modules that has comedi_test, else a package linux-image-*.deb in
# $HANDLOOP_QEMU_KERNEL (apt-get download linux-image-6.1.0-NN-amd64).
set -eu
probe=$1
work=$2
skip() {
  echo "skipped: $1"
  exit 77
}
qemu=$(command -v qemu-system-x86_64) || skip "qemu-system-x86_64 is missing (apt-get install qemu-system-x86)"
busybox=$(command -v busybox) || skip "busybox is missing (apt-get install busybox-static)"
[ "$(uname -m)" = x86_64 ] || skip "the probe is not an x86-64 program"
rm -rf "$work"
mkdir -p "$work/root/bin" "$work/root/proc" "$work/root/sys" "$work/root/dev" "$work/kernel"

modules= kernel=
for candidate in /lib/modules/*/kernel/drivers/comedi/drivers/comedi_test.ko*; do
  [ -e "$candidate" ] || continue
  version=$(echo "$candidate" | cut -d/ -f4)
  [ -r "/boot/vmlinuz-$version" ] && modules=/lib/modules/$version/kernel/drivers/comedi kernel=/boot/vmlinuz-$version
done
if [ -z "$kernel" ] && [ -n "${HANDLOOP_QEMU_KERNEL:-}" ]; then
  for package in "$HANDLOOP_QEMU_KERNEL"/linux-image-*.deb; do
    [ -e "$package" ] || skip "no linux-image-*.deb in $HANDLOOP_QEMU_KERNEL"
    dpkg-deb --fsys-tarfile "$package" | tar -x -C "$work/kernel" --wildcards './boot/vmlinuz*' \
      './lib/modules/*/drivers/comedi/*'
  done
  kernel=$(ls "$work"/kernel/boot/vmlinuz-* | tail -1)
  modules=$(ls -d "$work"/kernel/lib/modules/*/kernel/drivers/comedi | tail -1)
fi
[ -n "$kernel" ] || skip "no Debian kernel with comedi_test (install linux-image-amd64 or set HANDLOOP_QEMU_KERNEL)"

# A root file system in memory: busybox, two modules, the probe and the libraries it needs.
for module in "$modules/comedi.ko" "$modules/drivers/comedi_test.ko"; do
  if [ -e "$module" ]; then cp "$module" "$work/root/"; else xz -dc "$module.xz" > "$work/root/$(basename "$module")"; fi
done
cp "$busybox" "$work/root/bin/busybox"
cp "$probe" "$work/root/probe"
ldd "$probe" "$busybox" 2>/dev/null | grep -o '/[^ ]*' | grep -v ':$' | sort -u | while read -r library; do
  mkdir -p "$work/root$(dirname "$library")"
  cp -L "$library" "$work/root$library"
done
cat > "$work/root/init" <<'INIT'
#!/bin/busybox sh
/bin/busybox mount -t proc none /proc
/bin/busybox mount -t sysfs none /sys
/bin/busybox mount -t devtmpfs none /dev
/bin/busybox insmod /comedi.ko
/bin/busybox insmod /comedi_test.ko
/probe
/bin/busybox poweroff -f
INIT
sed -i 's|/bin/busybox sh|/bin/busybox sh|' "$work/root/init"
chmod +x "$work/root/init"
(cd "$work/root" && find . | "$busybox" cpio -o -H newc 2>/dev/null) > "$work/initramfs"

timeout 200 "$qemu" -accel tcg -m 512 -nographic -no-reboot -nodefaults -serial stdio -kernel "$kernel" \
  -initrd "$work/initramfs" -append "console=ttyS0 quiet panic=-1" > "$work/console.txt" 2>&1 < /dev/null || true
cat "$work/console.txt"
rm -rf "$work/root" "$work/kernel" "$work/initramfs"
grep -q "PROBE OK" "$work/console.txt"
