//! Which commands of a page run: the newest first, those that somebody waits for, and background work when nothing else runs.

use crate::command;
use command::explore::{STREAM, Server, begun, whole};
use serde_json::{Value, json};
use std::io::Read;
use std::net::TcpStream;
use std::time::Duration;

/// Runs that write a line at once, and do not end before somebody reads them, or leaves: their lines are more than may wait to be read.
fn endless() -> Value {
    json!({"driving": 0.102, "stiffness": 0.2, "until": 1e7, "points": 190_000})
}

/// A command of a moment.
fn short() -> Value {
    json!({"points": 3})
}

const BACKGROUND: (&str, &str) = ("Priority", "u=6");

/// How many commands run at once.
fn places() -> usize {
    std::thread::available_parallelism().map_or(2, |cores| cores.get().max(2)) + 2
}

/// As many commands as run at once.
fn full(server: &Server) -> Vec<TcpStream> {
    let begin = |_| {
        let mut stream = server.ask("integrate", &endless(), &[STREAM]);
        begun(&mut stream);
        stream
    };
    (0..places()).map(begin).collect()
}

/// Whether nothing comes for a while.
fn is_silent(stream: &mut TcpStream) -> bool {
    let patience = stream.read_timeout().expect("a timeout");
    stream
        .set_read_timeout(Some(Duration::from_millis(300)))
        .expect("a timeout");
    let mut bytes = [0; 1 << 16];
    let silent = stream.read(&mut bytes).is_err();
    stream.set_read_timeout(patience).expect("a timeout");
    silent
}

/// Takes the head of an answer.
fn past_head(stream: &mut TcpStream) {
    let mut all = Vec::new();
    let mut byte = [0];
    while !all.ends_with(b"\r\n\r\n") {
        stream.read_exact(&mut byte).expect("a head");
        all.push(byte[0]);
    }
}

#[test]
fn a_command_stops_when_its_client_leaves() {
    let server = Server::start(&[]);
    for accepts in [&[STREAM][..], &[]] {
        let mut running = full(&server);
        // There is no place for it until one of them is stopped.
        let waiting = server.ask("law", &short(), accepts);
        drop(running.pop());
        assert_eq!(whole(waiting).status, 200);
        drop(running);
    }
    // Nobody reads what was asked for as a whole.
    for _ in 0..4 * places() {
        drop(server.ask("integrate", &endless(), &[]));
    }
    assert_eq!(server.object("law", &short()).status, 200);
}

#[test]
fn the_newest_command_runs_first_and_those_of_clients_that_left_never() {
    let server = Server::start(&[]);
    let mut running = full(&server);
    let mut waiting: Vec<TcpStream> = (0..4)
        .map(|_| {
            let mut stream = server.ask("integrate", &endless(), &[STREAM]);
            // The answer begins, and its lines do not.
            past_head(&mut stream);
            stream
        })
        .collect();
    assert!(waiting.iter_mut().all(is_silent));
    // The last one takes the first place; the third has left; the second is next.
    drop(waiting.remove(2));
    for _ in 0..3 {
        drop(running.pop());
        let mut newest = waiting.pop().expect("one that waits");
        newest.read_exact(&mut [0]).expect("its first line");
        running.push(newest);
        assert!(waiting.iter_mut().all(is_silent));
    }
}

#[test]
fn too_many_commands_that_wait_are_refused() {
    let server = Server::start(&[]);
    let running = full(&server);
    let mut waiting: Vec<TcpStream> = (0..48)
        .map(|_| server.ask("law", &short(), &[STREAM]))
        .collect();
    waiting.iter_mut().for_each(past_head);
    let answer = server.object("law", &short());
    assert_eq!(answer.status, 503);
    assert!(
        answer.message().contains("48 commands wait already"),
        "{}",
        answer.body
    );
    // Those whose clients leave make room.
    drop(waiting);
    drop(running);
    assert_eq!(server.object("law", &short()).status, 200);
}

#[test]
fn background_work_waits_while_other_work_runs() {
    let server = Server::start(&[]);
    let mut behind = server.ask("integrate", &endless(), &[STREAM, BACKGROUND]);
    begun(&mut behind);
    let mut urgent = server.ask("integrate", &endless(), &[STREAM]);
    begun(&mut urgent);
    // What is on its way still comes.
    while !is_silent(&mut behind) {}
    urgent.read_exact(&mut [0; 1000]).expect("it goes on");
    drop(urgent);
    behind.read_exact(&mut [0; 1000]).expect("it goes on");
    // It has a place of its own, and takes none of the others.
    let running = full(&server);
    while !is_silent(&mut behind) {}
    drop(running);
    behind.read_exact(&mut [0; 1000]).expect("it goes on");
}

#[test]
fn a_client_that_reads_slowly_slows_its_command_down_and_no_other() {
    let server = Server::start(&[]);
    let mut slow = server.ask("integrate", &endless(), &[STREAM]);
    begun(&mut slow);
    for _ in 0..20 {
        assert_eq!(server.object("law", &short()).status, 200);
    }
    let mut rest = String::new();
    slow.read_to_string(&mut rest).expect("all of it");
    assert!(
        rest.len() > 20 << 20 && rest.contains("{\"ended\":"),
        "{}",
        rest.len()
    );
}
