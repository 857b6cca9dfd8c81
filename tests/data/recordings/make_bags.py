#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the ROS 1 bags of this folder with python3-rosbag, and the ROS 2 bag from the messages of make_mcap.mjs.

Needs python3-rosbag, python3-sensor-msgs and python3-tf2-msgs. Run make_mcap.mjs first. The scene: see README.md.
"""
import base64
import json
import sqlite3
import struct
import subprocess
import sys

import genpy
import rosbag
from geometry_msgs.msg import Transform, TransformStamped
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Float32
from tf2_msgs.msg import TFMessage

WIDTH, HEIGHT, VIEWS = 16, 12, 4
K = [20.0, 0, 7.5, 0, 21.0, 5.5, 0, 0, 1]


def stamp(seconds):
    return genpy.Time.from_sec(seconds)


def color(i, frame="camera_color_optical_frame"):
    message = Image(height=HEIGHT, width=WIDTH, encoding="rgb8", step=3 * WIDTH)
    message.header.stamp = stamp(100 + 0.1 * i)
    message.header.frame_id = frame
    message.data = bytes(c for v in range(HEIGHT) for u in range(WIDTH) for c in (10 * u + i, 15 * v, 100))
    return message


def depth(i, frame="camera_color_optical_frame", encoding="16UC1"):
    message = Image(height=HEIGHT, width=WIDTH, encoding=encoding, step=2 * WIDTH)
    message.header.stamp = stamp(100.005 + 0.1 * i)
    message.header.frame_id = frame
    values = [0 if u + v == 0 else 1000 + 10 * u + i for v in range(HEIGHT) for u in range(WIDTH)]
    message.data = struct.pack("<%dH" % len(values), *values)
    return message


def info(frame, k):
    message = CameraInfo(height=HEIGHT, width=WIDTH, distortion_model="plumb_bob")
    message.header.frame_id = frame
    message.D = [0.0] * 5
    message.K = k
    message.P = k[0:3] + [0.0] + k[3:6] + [0.0] + k[6:9] + [0.0]
    return message


def transform(parent, child, seconds, translation, rotation):
    message = TransformStamped()
    message.header.stamp = stamp(seconds)
    message.header.frame_id = parent
    message.child_frame_id = child
    t, r = message.transform.translation, message.transform.rotation
    t.x, t.y, t.z = translation
    r.x, r.y, r.z, r.w = rotation
    return TFMessage(transforms=[message])


def write_ros1(name, compression):
    with rosbag.Bag(name, "w", compression=compression, chunk_threshold=2000) as bag:
        optical = transform("camera_link", "camera_color_optical_frame", 99, (0, 0.02, 0), (-0.5, 0.5, -0.5, 0.5))
        bag.write("/tf_static", optical, stamp(99))
        bag.write("/camera/color/camera_info", info("camera_color_optical_frame", K), stamp(99))
        for i in range(VIEWS + 1):
            moved = transform("world", "camera_link", 100 + 0.1 * i, (0.1 * i, 0, 0), (0, 0, 0, 1))
            bag.write("/tf", moved, stamp(100 + 0.1 * i))
            if i == VIEWS:
                break
            bag.write("/camera/color/image_raw", color(i), stamp(100.01 + 0.1 * i))
            bag.write("/camera/aligned_depth_to_color/image_raw", depth(i), stamp(100.012 + 0.1 * i))


def write_realsense(name):
    """The topics of librealsense: depth with a camera, a unit and a place of its own."""
    prefix = "/device_0/sensor_0/Depth_0"
    color_prefix = "/device_0/sensor_1/Color_0"
    with rosbag.Bag(name, "w", compression="lz4") as bag:
        bag.write(prefix + "/info/camera_info", info("", K), stamp(99))
        bag.write(color_prefix + "/info/camera_info", info("", K), stamp(99))
        reference = Transform()
        reference.rotation.w = 1
        bag.write(prefix + "/tf/0", reference, stamp(99))
        color_from_depth = Transform()
        color_from_depth.rotation.w = 1
        color_from_depth.translation.x = 0.1
        bag.write(color_prefix + "/tf/0", color_from_depth, stamp(99))
        bag.write("/device_0/sensor_0/option/Depth_Units/value", Float32(data=0.0005), stamp(99))
        for i in range(2):
            wall = depth(i, "0", "mono16")
            wall.data = struct.pack("<%dH" % (WIDTH * HEIGHT), *([2000] * (WIDTH * HEIGHT)))
            bag.write(prefix + "/image/data", wall, stamp(100 + 0.1 * i))
            bag.write(color_prefix + "/image/data", color(i, "0"), stamp(100 + 0.1 * i))


def compressed(data):
    return subprocess.run(["zstd", "-q", "-c"], input=data, capture_output=True, check=True).stdout


def write_ros2(name, messages, encode=bytes):
    database = sqlite3.connect(name)
    database.executescript(
        """CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
             serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
           CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
             data BLOB NOT NULL);
           CREATE INDEX timestamp_idx ON messages (timestamp ASC);"""
    )
    topics = {}
    for message in messages:
        if message["topic"] not in topics:
            topics[message["topic"]] = len(topics) + 1
            database.execute(
                "INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')",
                (topics[message["topic"]], message["topic"], message["type"]),
            )
        database.execute(
            "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
            (topics[message["topic"]], int(message["time"]), encode(base64.b64decode(message["data"]))),
        )
    database.commit()
    database.execute("VACUUM")
    database.close()


write_ros1("none.bag", rosbag.Compression.NONE)
write_ros1("bz2.bag", rosbag.Compression.BZ2)
write_ros1("lz4.bag", rosbag.Compression.LZ4)
write_realsense("realsense.bag")
with open(sys.argv[1]) as file:
    messages = json.load(file)
write_ros2("ros2.db3", messages)
write_ros2("ros2_zstd.db3", messages, compressed)
