"""A name server at 127.0.0.11 that knows one name, geosis: usage: names.py ADDRESS ..."""
import socket
import struct
import sys

server = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
server.bind(("127.0.0.11", 53))
ADDRESS_RECORD, SECONDS = 1, 1
while True:
    asked, client = server.recvfrom(512)
    question = asked[12:asked.index(b"\0", 12) + 5]
    (kind,) = struct.unpack(">H", question[-4:-2])
    known = sys.argv[1:] if question.startswith(b"\6geosis\0") and kind == ADDRESS_RECORD else []
    head = asked[:2] + struct.pack(">HHHHH", 0x8180, 1, len(known), 0, 0)
    answers = b"".join(struct.pack(">HHHIH", 0xC00C, ADDRESS_RECORD, 1, SECONDS, 4) + socket.inet_aton(address) for address in known)
    server.sendto(head + question + answers, client)
