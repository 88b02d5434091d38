#!/bin/busybox sh
# The guest's only program: attaches the emulated board to this kernel and uses it as a person would. Each promise is
# one line, "CHECK ok ..." or "CHECK failed ...", for emulator/tests/linux.rs.

/bin/busybox mkdir -p /proc /sys /dev /tmp /bin
/bin/busybox --install -s /bin
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs devtmpfs /dev
port=$(sed -n 's/.*board=\([0-9]*\).*/\1/p' /proc/cmdline)
vhci=/sys/devices/platform/vhci_hcd.0
tty=/dev/ttyACM0

check() {
    if [ "$2" = 0 ]; then echo "CHECK ok $1"; else echo "CHECK failed $1"; fi
}

# Waits up to 20 s until a command succeeds.
until_true() {
    n=0
    until "$@"; do
        n=$((n + 1))
        [ $n -lt 200 ] || return 1
        usleep 100000
    done
}

attach() {
    nc 10.0.2.2 "$port" -e /attach.sh
    until_true test -c $tty || return 1
    # A terminal echoes until it is told not to, and the board takes its own lines for keys: back to quaternions.
    stty -F $tty raw -echo
    sleep 1
    printf 5 >$tty
}

# So many lines of the stream, after the settings given.
read_lines() {
    count=$1
    shift
    timeout 120 sh -c "stty raw -echo $* <&0; head -n $count" <$tty
}

while read -r module; do insmod "/modules/$module"; done </modules/order
ifconfig lo 127.0.0.1
until_true ifconfig eth0 10.0.2.15 netmask 255.255.255.0 up

attach
check "the kernel attaches the board and cdc_acm binds to it" $?
device=$(echo $vhci/usb*/*-1/manufacturer)
device=${device%/manufacturer}
[ "$(cat "$device/idVendor"):$(cat "$device/idProduct") $(cat "$device/manufacturer")" = "16c0:0483 Teensyduino" ]
check "the kernel reads identity and strings" $?

read_lines 100 >/tmp/stream
[ "$(grep -c '^QC [-0-9. ]*.$' /tmp/stream)" -ge 80 ]
check "the stream arrives" $?

grep -q '^vrduino ' /tmp/stream && read_lines 10 | grep -q '^vrduino '
check "each opening is seen through DTR, and answered with a banner" $?

all=0
for coding in 300 "9600 cs7 parenb" "57600 cs8 -parenb cstopb" "115200 -cstopb" 921600; do
    read_lines 5 "$coding" >/tmp/stream || all=1
    [ "$(wc -l </tmp/stream)" = 5 ] || all=1
done
check "line codings are accepted" $all

(sleep 1; printf 2; sleep 2) >$tty &
read_lines 400 115200 | grep -q '^EA '
check "keys reach the board under traffic" $?
wait

all=0
for n in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    timeout 60 head -c $((n * 37)) <$tty >/tmp/stream || all=1
done
read_lines 20 >/tmp/stream || all=1
check "the port opens and closes under traffic" $all

gone() { [ ! -e $tty ]; }
echo 0 >$vhci/detach
until_true gone
check "the board can be detached" $?
attach && read_lines 20 >/tmp/stream
check "and attached once more" $?

# While the stream is being read.
cat $tty >/dev/null 2>&1 &
reader=$!
sleep 1
echo 0 >$vhci/detach
until_true gone && attach && read_lines 20 >/tmp/stream
check "and unplugged and replugged while it streams" $?
kill $reader 2>/dev/null

# A plug that is pulled while the kernel sends a command leaves it with a broken pipe: that is the plug's doing.
dmesg | grep -E 'usb|vhci|acm' | grep -v 'sendmsg failed!, ret=-32' >/tmp/log
! grep -iE 'error|fail|cannot|unable|timed out|timeout|bogus|invalid|not accepting|WARNING|stall|descriptor read' /tmp/log
check "the kernel finds nothing to object to" $?

echo "KERNEL LOG"
dmesg | grep -E 'usb [0-9]+-1|acm'
poweroff -f
